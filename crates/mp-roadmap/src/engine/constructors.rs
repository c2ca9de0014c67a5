//! The constructors that every variant has.

/// Writes `new`, with the nearest neighbours that suit the space, and `with_index`, with any. Takes a name
/// for people, the type, the bounds on its parameters beyond the usual ones, and a closure from the space and
/// the arguments to the parts.
macro_rules! constructors {
    (
        $what:literal $variant:ident<C, L, N $(, $param:ident)*> $(where [$($bounds:tt)+])?,
        |$space:pat_param $(, $arg:ident: $type:ty)*| $parts:expr
    ) => {
        impl<'c, C, L, N $(, $param)*> $variant<'c, C, L, N $(, $param)*>
        where
            C: mp_cspace::Space,
            L: mp_cspace::LocalPlanner<C::State, Edge: mp_cspace::Reversible>,
            N: mp_cspace::NearestNeighbors<C>,
            $($($bounds)+)?
        {
            #[doc = concat!($what, " with the nearest neighbours that suit the space.")]
            ///
            /// # Errors
            /// When a parameter is out of range.
            pub fn new(
                problem: mp_cspace::Problem<'c, C, L>,
                $($arg: $type),*
            ) -> Result<Self, mp_cspace::BuildError>
            where
                C: mp_cspace::DefaultNn<Nn = N>,
                N: Default,
            {
                Self::with_index(problem, N::default() $(, $arg)*)
            }

            #[doc = concat!($what, " with an empty index of your choice.")]
            ///
            /// # Errors
            /// When a parameter is out of range.
            pub fn with_index(
                problem: mp_cspace::Problem<'c, C, L>,
                index: N,
                $($arg: $type,)*
            ) -> Result<Self, mp_cspace::BuildError> {
                let $space = problem.space();
                let parts = $parts?;
                Ok(Self::assemble(problem, index, parts))
            }
        }
    };
}

pub(crate) use constructors;
