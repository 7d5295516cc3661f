//! How values become bytes and bytes values, in the order of their fields, lowest byte first.

use raywood::Vec3;

/// Bytes that values are read from, one after the other.
pub(super) struct Reader<'a> {
    pub(super) bytes: &'a [u8],
    /// How many were read.
    pub(super) at: usize,
}

/// Why bytes are not the value that is expected: the byte at which it begins, and what is wrong.
#[derive(Debug)]
pub(super) struct Fault {
    pub(super) at: usize,
    pub(super) problem: String,
}

impl<'a> Reader<'a> {
    /// The next so many bytes.
    pub(super) fn take(&mut self, count: usize) -> Result<&'a [u8], Fault> {
        match self.bytes.get(self.at..).and_then(|rest| rest.get(..count)) {
            Some(bytes) => {
                self.at += count;
                Ok(bytes)
            }
            None => Err(self.fault(format!("{count} more bytes are expected, but it ends"))),
        }
    }

    /// A fault of what begins at the next byte.
    pub(super) fn fault(&self, problem: impl Into<String>) -> Fault {
        Fault { at: self.at, problem: problem.into() }
    }
}

/// What can be written as bytes and read again, to the bit.
pub(super) trait Stored: Sized {
    /// Appends it.
    fn put(&self, bytes: &mut Vec<u8>);

    /// Reads it.
    fn get(reader: &mut Reader<'_>) -> Result<Self, Fault>;
}

impl Stored for u32 {
    fn put(&self, bytes: &mut Vec<u8>) {
        bytes.extend(self.to_le_bytes());
    }

    fn get(reader: &mut Reader<'_>) -> Result<Self, Fault> {
        let mut number = [0; 4];
        number.copy_from_slice(reader.take(4)?);
        Ok(Self::from_le_bytes(number))
    }
}

impl Stored for f32 {
    fn put(&self, bytes: &mut Vec<u8>) {
        self.to_bits().put(bytes);
    }

    fn get(reader: &mut Reader<'_>) -> Result<Self, Fault> {
        u32::get(reader).map(Self::from_bits)
    }
}

/// As four bytes.
impl Stored for u8 {
    fn put(&self, bytes: &mut Vec<u8>) {
        u32::from(*self).put(bytes);
    }

    fn get(reader: &mut Reader<'_>) -> Result<Self, Fault> {
        let start = reader.at;
        let number = u32::get(reader)?;
        Self::try_from(number)
            .map_err(|_| Fault { at: start, problem: format!("{number}, expected at most 255") })
    }
}

/// One after the other.
impl<T: Stored + Copy + Default, const N: usize> Stored for [T; N] {
    fn put(&self, bytes: &mut Vec<u8>) {
        self.iter().for_each(|value| value.put(bytes));
    }

    fn get(reader: &mut Reader<'_>) -> Result<Self, Fault> {
        let mut values = [T::default(); N];
        for value in &mut values {
            *value = T::get(reader)?;
        }
        Ok(values)
    }
}

/// One after the other.
impl<A: Stored, B: Stored> Stored for (A, B) {
    fn put(&self, bytes: &mut Vec<u8>) {
        self.0.put(bytes);
        self.1.put(bytes);
    }

    fn get(reader: &mut Reader<'_>) -> Result<Self, Fault> {
        Ok((A::get(reader)?, B::get(reader)?))
    }
}

/// As what it holds.
impl<T: Stored> Stored for Box<T> {
    fn put(&self, bytes: &mut Vec<u8>) {
        (**self).put(bytes);
    }

    fn get(reader: &mut Reader<'_>) -> Result<Self, Fault> {
        T::get(reader).map(Self::new)
    }
}

impl Stored for Vec3 {
    fn put(&self, bytes: &mut Vec<u8>) {
        self.to_array().iter().for_each(|number| number.put(bytes));
    }

    fn get(reader: &mut Reader<'_>) -> Result<Self, Fault> {
        Ok(Self::new(f32::get(reader)?, f32::get(reader)?, f32::get(reader)?))
    }
}

/// The number of bytes, and then these in UTF-8.
impl Stored for String {
    fn put(&self, bytes: &mut Vec<u8>) {
        (self.len() as u32).put(bytes);
        bytes.extend(self.as_bytes());
    }

    fn get(reader: &mut Reader<'_>) -> Result<Self, Fault> {
        let length = u32::get(reader)?;
        let start = reader.at;
        let text = reader.take(length as usize)?.to_vec();
        Self::from_utf8(text)
            .map_err(|_| Fault { at: start, problem: "a text is not UTF-8".to_owned() })
    }
}

/// 0, or 1 and the value.
impl<T: Stored> Stored for Option<T> {
    fn put(&self, bytes: &mut Vec<u8>) {
        u32::from(self.is_some()).put(bytes);
        self.iter().for_each(|value| value.put(bytes));
    }

    fn get(reader: &mut Reader<'_>) -> Result<Self, Fault> {
        match u32::get(reader)? {
            0 => Ok(None),
            1 => T::get(reader).map(Some),
            other => Err(reader.fault(format!("{other} before this, expected 0 or 1"))),
        }
    }
}

/// How many there are, and then each.
impl<T: Stored> Stored for Vec<T> {
    fn put(&self, bytes: &mut Vec<u8>) {
        (self.len() as u32).put(bytes);
        self.iter().for_each(|value| value.put(bytes));
    }

    fn get(reader: &mut Reader<'_>) -> Result<Self, Fault> {
        let count = u32::get(reader)?;
        // No memory before it is known that there are as many: every value has bytes.
        (0..count).map(|_| T::get(reader)).collect()
    }
}

/// A structure is stored as its fields, all of them, in this order.
macro_rules! stored_struct {
    ($name:ident { $($field:ident),* $(,)? }) => {
        impl Stored for $name {
            fn put(&self, bytes: &mut Vec<u8>) {
                let Self { $($field),* } = self;
                $($field.put(bytes);)*
            }

            fn get(reader: &mut Reader<'_>) -> Result<Self, Fault> {
                Ok(Self { $($field: Stored::get(reader)?),* })
            }
        }
    };
}

/// An enumeration is stored as the number of the variant, and the variant's fields in this order.
macro_rules! stored_enum {
    ($name:ident { $($number:literal => $variant:ident { $($field:ident),* }),* $(,)? }) => {
        impl Stored for $name {
            fn put(&self, bytes: &mut Vec<u8>) {
                match self {
                    $(Self::$variant { $($field),* } => {
                        u32::put(&$number, bytes);
                        $($field.put(bytes);)*
                    })*
                }
            }

            fn get(reader: &mut Reader<'_>) -> Result<Self, Fault> {
                let start = reader.at;
                match u32::get(reader)? {
                    $($number => Ok(Self::$variant { $($field: Stored::get(reader)?),* }),)*
                    other => Err(Fault {
                        at: start,
                        problem: format!(concat!("{} is no ", stringify!($name)), other),
                    }),
                }
            }
        }
    };
}

pub(super) use {stored_enum, stored_struct};
