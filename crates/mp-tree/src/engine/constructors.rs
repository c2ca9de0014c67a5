//! The constructors that nearly every variant has.

/// Writes `new`, with the nearest neighbours that suit the space, and `with_index`, with any. Takes a name
/// for people, the type, the bounds on its parameters beyond the usual ones, and the body of `with_index`
/// with its arguments. `new` does not take an argument behind a semicolon, but uses its default.
macro_rules! constructors {
    (
        $what:literal $variant:ident<C, L, N $(, $param:ident)*> $(where [$($bounds:tt)+])?,
        |$problem:ident, $index:ident $(, $arg:ident: $type:ty)* $(; $more:ident: $kind:ty = [$default:expr])?| $body:block
    ) => {
        impl<'c, C, L, N $(, $param)*> $variant<'c, C, L, N $(, $param)*>
        where
            C: mp_cspace::Space,
            L: mp_cspace::LocalPlanner<C::State>,
            N: mp_cspace::NearestNeighbors<C>,
            $($($bounds)+)?
        {
            #[doc = concat!($what, " with the nearest neighbours that suit the space.")]
            ///
            /// # Errors
            /// When a parameter is out of range, or the problem lacks what the planner needs.
            pub fn new(
                problem: mp_cspace::Problem<'c, C, L>,
                $($arg: $type),*
            ) -> Result<Self, mp_cspace::BuildError>
            where
                C: mp_cspace::DefaultNn<Nn = N>,
                N: Default,
            {
                Self::with_index(problem, N::default() $(, $arg)* $(, $default)?)
            }

            #[doc = concat!($what, " with an empty index of your choice.")]
            ///
            /// # Errors
            /// When a parameter is out of range, or the problem lacks what the planner needs.
            pub fn with_index(
                $problem: mp_cspace::Problem<'c, C, L>,
                $index: N,
                $($arg: $type,)*
                $($more: $kind,)?
            ) -> Result<Self, mp_cspace::BuildError>
            $body
        }
    };
}

pub(crate) use constructors;
