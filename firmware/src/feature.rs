//! What of the core is built. Each cargo feature has a box here; what belongs to it, a block's configuration or a mode's
//! state, lives in that box. Without the feature the box is a type without values: an `Option` of it is always `None`, a
//! mode of it is never entered, and the compiler leaves their code out. No other line of the core asks what is built.

use core::ops::{Deref, DerefMut};

macro_rules! boxes {
    ($($(#[$doc:meta])+ $name:ident: $feature:tt;)+) => {$(
        $(#[$doc])+
        #[cfg(feature = $feature)]
        #[derive(Clone, Copy, Debug)]
        pub(crate) struct $name<T>(T);

        $(#[$doc])+
        #[cfg(not(feature = $feature))]
        #[derive(Clone, Copy, Debug)]
        pub(crate) enum $name<T> {
            #[allow(dead_code, reason = "has no value")]
            Never(core::convert::Infallible, core::marker::PhantomData<T>),
        }

        impl<T> $name<T> {
            /// Whether it is built.
            #[allow(dead_code, reason = "only modes are refused by it")]
            pub const IS_BUILT: bool = cfg!(feature = $feature);

            /// What `make` makes, if this is built.
            #[inline]
            #[cfg_attr(not(feature = $feature), expect(unused_variables, reason = "never called"))]
            pub fn build(make: impl FnOnce() -> Option<T>) -> Option<Self> {
                #[cfg(feature = $feature)]
                return make().map(Self);
                #[cfg(not(feature = $feature))]
                return None;
            }
        }

        impl<T> Deref for $name<T> {
            type Target = T;

            #[inline]
            fn deref(&self) -> &T {
                #[cfg(feature = $feature)]
                return &self.0;
                #[cfg(not(feature = $feature))]
                match self {
                    Self::Never(never, _) => match *never {},
                }
            }
        }

        impl<T> DerefMut for $name<T> {
            #[inline]
            fn deref_mut(&mut self) -> &mut T {
                #[cfg(feature = $feature)]
                return &mut self.0;
                #[cfg(not(feature = $feature))]
                match self {
                    Self::Never(never, _) => match *never {},
                }
            }
        }
    )+};
}

boxes! {
    /// The position filter on a tether.
    Cable: "cable";
    /// The full-state filter beside it.
    FullState: "full-state";
    /// Taut Force, Taut Attitude, their observer, the slack start.
    TautLink: "taut-link";
    /// Tether Angle and its filters.
    TetherAngle: "tether-angle";
    /// Pendulum and its filter.
    Pendulum: "pendulum";
    /// The position filter on motion capture.
    Capture: "capture";
}
