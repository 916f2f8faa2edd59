//! Instruction set of the kernels.

use bevy_reflect::prelude::*;
use fearless_simd::Level;

/// Instruction set of the kernels. A set that the machine does not have is replaced by the best that it has below.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Default)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
pub enum ClothInstructionSet {
    /// The best of this machine.
    #[default]
    Auto,
    /// One number at a time.
    Scalar,
    /// 4 numbers at a time; every x86-64 processor.
    Sse2,
    /// 8 numbers at a time; x86-64-v3.
    Avx2,
    /// 16 numbers at a time; from Ice Lake and Zen 4 on.
    Avx512,
}

impl ClothInstructionSet {
    /// Level of the vector library.
    pub fn level(self) -> Level {
        let best = Level::new();
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        {
            let sse2 = || best.as_sse2().map(Level::Sse2);
            let avx2 = || best.as_avx2().map(Level::Avx2);
            match self {
                Self::Scalar => Some(Level::fallback()),
                Self::Sse2 => sse2(),
                Self::Avx2 => avx2().or_else(sse2),
                Self::Auto | Self::Avx512 => None,
            }
            .unwrap_or(best)
        }
        #[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
        match self {
            Self::Scalar => Level::fallback(),
            _ => best,
        }
    }
}

/// Calls a kernel for two instruction sets only: there are many that few cloths need, and each instruction set takes long to compile.
macro_rules! for_few {
    ($level:expr, $simd:ident => $do:expr) => {{
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        let level = $level
            .as_avx2()
            .map_or(fearless_simd::Level::fallback(), fearless_simd::Level::Avx2);
        #[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
        let level = $level;
        match level {
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            fearless_simd::Level::Avx2($simd) => $simd.vectorize(
                #[inline(always)]
                || $do,
            ),
            #[cfg(target_arch = "aarch64")]
            fearless_simd::Level::Neon($simd) => $simd.vectorize(
                #[inline(always)]
                || $do,
            ),
            _ => {
                let $simd = fearless_simd::Fallback::new();
                $do
            }
        }
    }};
}
pub(crate) use for_few;

/// All levels of this machine, the plainest first.
pub fn levels() -> Vec<Level> {
    let best = Level::new();
    let mut levels = vec![Level::fallback()];
    #[cfg(target_arch = "x86_64")]
    {
        levels.extend(best.as_sse2().map(Level::Sse2));
        levels.extend(best.as_avx2().map(Level::Avx2));
        levels.extend(best.as_avx512().map(Level::Avx512));
    }
    #[cfg(not(target_arch = "x86_64"))]
    levels.push(best);
    levels
}
