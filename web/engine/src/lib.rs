//! The library as WebAssembly: files in memory and a request of JSON in, JSON out.
//!
//! The page writes bytes into the buffer that [`input`] returns, calls [`put`], [`ask`], [`part`] or [`take`], and reads
//! what [`output`] points at. Nothing is imported: the module has no clock, no disk and no network.

// Exported names are the only unsafe attribute; no pointer is followed here.
#![allow(unsafe_code, reason = "names of the exports")]

use abbe::verbs::{workbench_of_parts, workbench_part};
use abbe::{MemoryFiles, Run};
use std::cell::RefCell;

/// What the page and the engine hand each other.
#[derive(Default)]
struct Engine {
    files: MemoryFiles,
    input: Vec<u8>,
    output: Vec<u8>,
    /// Parts of a map, one behind the other.
    parts: Vec<u8>,
}

thread_local! {
    static ENGINE: RefCell<Engine> = RefCell::default();
}

/// Returns a buffer of `length` bytes for the page to write into.
#[unsafe(no_mangle)]
pub extern "C" fn input(length: usize) -> *mut u8 {
    ENGINE.with_borrow_mut(|engine| {
        engine.input.clear();
        engine.input.resize(length, 0);
        engine.input.as_mut_ptr()
    })
}

/// Takes a file: of the input the first `name_length` bytes are its name, the rest is its text.
#[unsafe(no_mangle)]
pub extern "C" fn put(name_length: usize) {
    ENGINE.with_borrow_mut(|engine| {
        let (name, rest) = engine.input.split_at(name_length.min(engine.input.len()));
        let text = |bytes| String::from_utf8_lossy(bytes).into_owned();
        let (name, rest) = (text(name), text(rest));
        engine.files = std::mem::take(&mut engine.files).with(name, rest);
    });
}

/// Answers the request that the input holds, and returns the number of bytes of the output.
#[unsafe(no_mangle)]
pub extern "C" fn ask() -> usize {
    ENGINE.with_borrow_mut(|engine| {
        let request = String::from_utf8_lossy(&engine.input);
        let parts = std::mem::take(&mut engine.parts);
        engine.output = workbench_of_parts(&request, parts, Run::with(&engine.files)).to_string().into_bytes();
        engine.output.len()
    })
}

/// Computes a part, from 0, of the map of the request that the input holds, and returns the number of its bytes, which
/// are the output.
#[unsafe(no_mangle)]
pub extern "C" fn part(index: usize, count: usize) -> usize {
    ENGINE.with_borrow_mut(|engine| {
        let request = String::from_utf8_lossy(&engine.input);
        engine.output = workbench_part(&request, index, count, Run::with(&engine.files));
        engine.output.len()
    })
}

/// Takes the bytes of the next part of the map that is asked for next.
#[unsafe(no_mangle)]
pub extern "C" fn take() {
    ENGINE.with_borrow_mut(|engine| engine.parts.append(&mut engine.input));
}

/// Returns the output.
#[unsafe(no_mangle)]
pub extern "C" fn output() -> *const u8 {
    ENGINE.with_borrow(|engine| engine.output.as_ptr())
}
