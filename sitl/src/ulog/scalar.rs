//! The types that stand in a file.

/// A type without parts, of the width that its name says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scalar {
    /// `int8_t`
    I8,
    /// `uint8_t`
    U8,
    /// `int16_t`
    I16,
    /// `uint16_t`
    U16,
    /// `int32_t`
    I32,
    /// `uint32_t`
    U32,
    /// `int64_t`
    I64,
    /// `uint64_t`
    U64,
    /// `float`
    F32,
    /// `double`
    F64,
    /// `bool`
    Bool,
    /// `char`
    Char,
}

impl Scalar {
    /// By its name in a definition.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Some(match name {
            "int8_t" => Self::I8,
            "uint8_t" => Self::U8,
            "int16_t" => Self::I16,
            "uint16_t" => Self::U16,
            "int32_t" => Self::I32,
            "uint32_t" => Self::U32,
            "int64_t" => Self::I64,
            "uint64_t" => Self::U64,
            "float" => Self::F32,
            "double" => Self::F64,
            "bool" => Self::Bool,
            "char" => Self::Char,
            _ => return None,
        })
    }

    /// Bytes.
    #[must_use]
    pub fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 | Self::Bool | Self::Char => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    /// The number at the beginning of `bytes`.
    #[must_use]
    pub fn number(self, bytes: &[u8]) -> Option<f64> {
        fn first<const N: usize>(bytes: &[u8]) -> Option<[u8; N]> {
            bytes.first_chunk().copied()
        }
        Some(match self {
            Self::I8 => i8::from_le_bytes(first(bytes)?).into(),
            Self::U8 | Self::Char => u8::from_le_bytes(first(bytes)?).into(),
            Self::Bool => f64::from(u8::from(first::<1>(bytes)? != [0])),
            Self::I16 => i16::from_le_bytes(first(bytes)?).into(),
            Self::U16 => u16::from_le_bytes(first(bytes)?).into(),
            Self::I32 => i32::from_le_bytes(first(bytes)?).into(),
            Self::U32 => u32::from_le_bytes(first(bytes)?).into(),
            Self::I64 => i64::from_le_bytes(first(bytes)?) as f64,
            Self::U64 => u64::from_le_bytes(first(bytes)?) as f64,
            Self::F32 => f32::from_le_bytes(first(bytes)?).into(),
            Self::F64 => f64::from_le_bytes(first(bytes)?),
        })
    }
}
