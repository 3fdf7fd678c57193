//! Text to what the file says, with places.
