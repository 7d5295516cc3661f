//! The types of numbers that are read.

/// A type of real numbers, with its byte order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Element {
    kind: Kind,
    big_endian: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    F32,
    F64,
    I8,
    I16,
    I32,
    I64,
    U8,
    U16,
    U32,
    U64,
}

impl Element {
    /// The type that numpy calls so, as `<f4` or `>i8`.
    pub(super) fn of_name(name: &str) -> Option<Self> {
        let (order, name) = match name.as_bytes().first()? {
            b'<' | b'|' => (Some(false), &name[1..]),
            b'>' => (Some(true), &name[1..]),
            b'=' => (Some(cfg!(target_endian = "big")), &name[1..]),
            _ => (None, name),
        };
        let kind = match name {
            "f4" => Kind::F32,
            "f8" => Kind::F64,
            "i1" => Kind::I8,
            "i2" => Kind::I16,
            "i4" => Kind::I32,
            "i8" => Kind::I64,
            "u1" => Kind::U8,
            "u2" => Kind::U16,
            "u4" => Kind::U32,
            "u8" => Kind::U64,
            _ => return None,
        };
        Some(Self { kind, big_endian: order.unwrap_or(false) })
    }

    /// How many bytes a number takes.
    pub(super) fn size(self) -> usize {
        match self.kind {
            Kind::I8 | Kind::U8 => 1,
            Kind::I16 | Kind::U16 => 2,
            Kind::F32 | Kind::I32 | Kind::U32 => 4,
            Kind::F64 | Kind::I64 | Kind::U64 => 8,
        }
    }

    /// Appends numbers given in bytes, rounded to single precision.
    pub(super) fn decode(self, bytes: &[u8], numbers: &mut Vec<f32>) {
        macro_rules! decode {
            ($type:ty) => {{
                const SIZE: usize = size_of::<$type>();
                let (chunks, _) = bytes.as_chunks::<SIZE>();
                match self.big_endian {
                    false => {
                        numbers.extend(chunks.iter().map(|&x| <$type>::from_le_bytes(x) as f32))
                    }
                    true => {
                        numbers.extend(chunks.iter().map(|&x| <$type>::from_be_bytes(x) as f32))
                    }
                }
            }};
        }
        match self.kind {
            Kind::F32 => decode!(f32),
            Kind::F64 => decode!(f64),
            Kind::I8 => decode!(i8),
            Kind::I16 => decode!(i16),
            Kind::I32 => decode!(i32),
            Kind::I64 => decode!(i64),
            Kind::U8 => decode!(u8),
            Kind::U16 => decode!(u16),
            Kind::U32 => decode!(u32),
            Kind::U64 => decode!(u64),
        }
    }
}
