//! Signatures of records: ed25519 (RFC 8032) over the bytes of `record.json`, which states the hash of every file.
//!
//! Keys are PEM files as `openssl genpkey -algorithm ed25519` and `openssl pkey -pubout` write them (RFC 8410).

use super::data::RecordSignature;
use crate::diagnostic::{Diagnostic, codes, shown};
use crate::run::{Call, Refused};
use crate::syntax::{ReadFailure, unreadable};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use std::path::Path;

/// The file of the signature: 64 bytes.
pub(crate) const SIGNATURE_NAME: &str = "record.json.sig";

/// Largest file of a key, in bytes; those of openssl have about 120.
const KEY_LIMIT: u64 = 16 << 10;

/// Label and DER prefix of a private key (PKCS #8).
const PRIVATE: (&str, &[u8]) = ("PRIVATE KEY", b"\x30\x2e\x02\x01\x00\x30\x05\x06\x03\x2b\x65\x70\x04\x22\x04\x20");

/// Label and DER prefix of a public key (SubjectPublicKeyInfo).
const PUBLIC: (&str, &[u8]) = ("PUBLIC KEY", b"\x30\x2a\x30\x05\x06\x03\x2b\x65\x70\x03\x21\x00");

/// A private key.
pub(crate) struct Signer([u8; 32]);

impl Signer {
    /// Reads a private key.
    pub fn read(call: &mut Call, path: &Path) -> Result<Self, Refused> {
        let help = "write one with `openssl genpkey -algorithm ed25519 -out KEY`";
        Ok(Self(read_key(call, path, PRIVATE, "private", help)?))
    }

    /// Returns what the record states.
    pub fn stated(&self, call: &mut Call) -> Result<RecordSignature, Refused> {
        let Some(key) = curve::public(&self.0) else { return lacks(call) };
        Ok(RecordSignature { algorithm: "ed25519".to_owned(), public_key: hex(&key), file: SIGNATURE_NAME.to_owned() })
    }

    /// Returns the signature of bytes.
    pub fn sign(&self, call: &mut Call, bytes: &[u8]) -> Result<Vec<u8>, Refused> {
        curve::sign(&self.0, bytes).map_or_else(|| lacks(call), Ok)
    }
}

/// Refuses a record whose signature does not hold, or, with a key, is not of this key.
/// `json` are the bytes of `record.json`, `signature` those of the file beside it.
pub(crate) fn verify(
    call: &mut Call,
    name: &str,
    stated: Option<&RecordSignature>,
    json: &[u8],
    signature: &[u8],
    key: Option<&Path>,
) -> Result<(), Refused> {
    let help = "write the public key with `openssl pkey -in KEY -pubout -out PUBLIC`";
    let key = key.map(|path| read_key(call, path, PUBLIC, "public", help)).transpose()?;
    let Some(stated) = stated else {
        let fault = refuse_signature(format!("`{name}` is not signed"), "take the record that was signed");
        return if key.is_some() { call.refuse(fault) } else { Ok(()) };
    };
    if key.is_some_and(|key| hex(&key) != stated.public_key) {
        let message = format!("`{name}` is signed by another key: {}", shown(&stated.public_key));
        return call.refuse(refuse_signature(message, "ask whoever signed it for the public key"));
    }
    let byte = |at: usize| u8::from_str_radix(stated.public_key.get(at..at + 2)?, 16).ok();
    let own: Option<Vec<u8>> = (0..32).map(|i| byte(2 * i)).collect();
    let own: Option<[u8; 32]> = own.and_then(|own| own.try_into().ok());
    let holds = own.filter(|_| stated.algorithm == "ed25519").map(|own| curve::holds(&own, json, signature));
    match holds {
        Some(None) => lacks(call),
        Some(Some(true)) => Ok(()),
        _ => call.refuse(refuse_changed(format!("the signature of `{name}` does not hold for its `record.json`"))),
    }
}

fn hex(key: &[u8; 32]) -> String {
    key.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Refuses a record that is not as it was written.
pub(crate) fn refuse_changed(message: String) -> Diagnostic {
    Diagnostic::new(codes::E0821, message).help("take the record from a copy, or make it again from its sources")
}

fn refuse_signature(message: String, help: &str) -> Diagnostic {
    Diagnostic::new(codes::E0823, message).help(help)
}

fn lacks<T>(call: &mut Call) -> Result<T, Refused> {
    call.refuse(refuse_signature("this build has no signatures".to_owned(), "take the program `abbe`"))
}

/// Reads the 32 bytes of a key; of what else stands in the file nothing is printed.
fn read_key(
    call: &mut Call,
    path: &Path,
    (label, prefix): (&str, &[u8]),
    kind: &str,
    help: &str,
) -> Result<[u8; 32], Refused> {
    let bytes = match call.run.files.read_at_most(path, KEY_LIMIT) {
        Ok(bytes) => bytes,
        // No key is that long.
        Err(ReadFailure::TooLarge(..)) => Vec::new(),
        Err(failure) => return call.refuse(unreadable(path, &failure)),
    };
    let key = std::str::from_utf8(&bytes).ok().and_then(|text| {
        let body = text.split_once(&format!("-----BEGIN {label}-----"))?.1;
        let body: String = body.split_once(&format!("-----END {label}-----"))?.0.split_whitespace().collect();
        STANDARD.decode(body).ok()?.strip_prefix(prefix)?.try_into().ok()
    });
    key.map_or_else(
        || {
            let message = format!("`{}` is no {kind} key of ed25519 in PEM", shown(&path.display().to_string()));
            call.refuse(refuse_signature(message, help))
        },
        Ok,
    )
}

#[cfg(feature = "signatures")]
mod curve {
    use ed25519_dalek::{Signature, Signer as _, SigningKey, VerifyingKey};

    /// Returns the public key; `None`, as below, in a build without signatures.
    pub fn public(secret: &[u8; 32]) -> Option<[u8; 32]> {
        Some(SigningKey::from_bytes(secret).verifying_key().to_bytes())
    }

    /// Returns the signature.
    pub fn sign(secret: &[u8; 32], bytes: &[u8]) -> Option<Vec<u8>> {
        Some(SigningKey::from_bytes(secret).sign(bytes).to_bytes().to_vec())
    }

    /// True if the signature is of this key, which is no weak one.
    pub fn holds(public: &[u8; 32], bytes: &[u8], signature: &[u8]) -> Option<bool> {
        let key = VerifyingKey::from_bytes(public).ok();
        let signature = Signature::from_slice(signature).ok();
        Some(key.zip(signature).is_some_and(|(key, signature)| key.verify_strict(bytes, &signature).is_ok()))
    }
}

#[cfg(not(feature = "signatures"))]
mod curve {
    pub fn public(_secret: &[u8; 32]) -> Option<[u8; 32]> {
        None
    }

    pub fn sign(_secret: &[u8; 32], _bytes: &[u8]) -> Option<Vec<u8>> {
        None
    }

    pub fn holds(_public: &[u8; 32], _bytes: &[u8], _signature: &[u8]) -> Option<bool> {
        None
    }
}
