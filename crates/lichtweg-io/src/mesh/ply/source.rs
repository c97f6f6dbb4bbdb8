//! The body of a PLY file as a stream of numbers, from text or from bytes of either order.

use super::header::Scalar;
use crate::mesh::text::Cursor;
use crate::mesh::{MeshError, Place};

/// Gives the body's numbers one by one.
pub(super) trait Source {
    /// The next number.
    fn value(&mut self, scalar: Scalar) -> Result<f64, MeshError>;

    /// Where that is.
    fn place(&self) -> Place;

    /// Bytes left.
    fn remaining(&self) -> usize;
}

impl Source for Cursor<'_> {
    fn value(&mut self, _scalar: Scalar) -> Result<f64, MeshError> {
        self.skip_whitespace();
        self.double()
    }

    fn place(&self) -> Place {
        Place::Line(self.line())
    }

    fn remaining(&self) -> usize {
        Cursor::remaining(self)
    }
}

/// Binary numbers; `BIG` is the byte order.
pub(super) struct Binary<'a, const BIG: bool> {
    /// The whole file.
    bytes: &'a [u8],
    position: usize,
}

impl<'a, const BIG: bool> Binary<'a, BIG> {
    /// Starts behind the header.
    pub fn new(bytes: &'a [u8], position: usize) -> Self {
        Self { bytes, position }
    }

    /// What is left, without moving on.
    pub fn rest(&self) -> &'a [u8] {
        &self.bytes[self.position..]
    }

    /// The next bytes.
    #[inline]
    pub fn take(&mut self, length: usize) -> Result<&'a [u8], MeshError> {
        match self.rest().get(..length) {
            Some(bytes) => {
                self.position += length;
                Ok(bytes)
            }
            None => Err(self.truncated(length)),
        }
    }

    #[cold]
    fn truncated(&self, length: usize) -> MeshError {
        MeshError::new(
            self.place(),
            format!("{length} more bytes"),
            format!("the end of the file after {}", self.remaining()),
            "the file is truncated; export or copy it again",
        )
    }
}

impl<const BIG: bool> Source for Binary<'_, BIG> {
    #[inline]
    fn value(&mut self, scalar: Scalar) -> Result<f64, MeshError> {
        Ok(decode::<BIG>(self.take(scalar.size())?, scalar))
    }

    fn place(&self) -> Place {
        Place::Byte(self.position as u64)
    }

    fn remaining(&self) -> usize {
        self.rest().len()
    }
}

/// The number in the first bytes of a slice that has enough of them.
#[inline]
pub(super) fn decode<const BIG: bool>(bytes: &[u8], scalar: Scalar) -> f64 {
    macro_rules! number {
        ($type:ty) => {{
            let array = bytes[..size_of::<$type>()].try_into().expect("sliced to this length");
            (if BIG { <$type>::from_be_bytes(array) } else { <$type>::from_le_bytes(array) }) as f64
        }};
    }
    match scalar {
        Scalar::I8 => number!(i8),
        Scalar::U8 => number!(u8),
        Scalar::I16 => number!(i16),
        Scalar::U16 => number!(u16),
        Scalar::I32 => number!(i32),
        Scalar::U32 => number!(u32),
        Scalar::I64 => number!(i64),
        Scalar::U64 => number!(u64),
        Scalar::F32 => number!(f32),
        Scalar::F64 => number!(f64),
    }
}
