//! The prelude of `proptest` with another `proptest!`, that tries the same cases.
//!
//! All that tries and shrinks cases is compiled for each test there; here once, for cases of any type.

use std::{
    any::Any,
    fmt::{self, Debug, Formatter},
};

pub use proptest::prelude::*;
use proptest::test_runner::{TestCaseResult, TestRunner};

macro_rules! for_all {
    (
        #![proptest_config($config:expr)]
        $($(#[$meta:meta])* fn $name:ident($($pattern:pat in $strategy:expr),+ $(,)?) $body:block)*
    ) => {$(
        $(#[$meta])*
        fn $name() {
            $crate::properties::check(
                ::proptest::test_runner::Config {
                    test_name: Some(concat!(module_path!(), "::", stringify!($name))),
                    source_file: Some(file!()),
                    ..::proptest::test_runner::contextualize_config($config)
                },
                stringify!($($pattern),+),
                ::proptest::proptest_helper!(@_WRAP ($($strategy)*)),
                |::proptest::proptest_helper!(@_WRAPPAT ($($pattern),*))| {
                    let (): () = $body;
                    Ok(())
                },
            );
        }
    )*};
    ($($(#[$meta:meta])* fn $name:ident($($pattern:pat in $strategy:expr),+ $(,)?) $body:block)*) => {
        $crate::properties::proptest! {
            #![proptest_config(::proptest::test_runner::Config::default())]
            $($(#[$meta])* fn $name($($pattern in $strategy),+) $body)*
        }
    };
}

pub(crate) use for_all as proptest;

/// Values that a test is tried with.
struct Case {
    names: &'static str,
    values: Box<dyn Values>,
}

trait Values: Any + Debug {}

impl<T: Any + Debug> Values for T {}

impl Debug for Case {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        write!(f, "({}) = {:?}", self.names, self.values)
    }
}

pub fn check<S: Strategy + 'static>(
    config: ProptestConfig,
    names: &'static str,
    strategy: S,
    test: impl Fn(S::Value) -> TestCaseResult,
) {
    let case = move |values| Case {
        names,
        values: Box::new(values),
    };
    run(config, &strategy.prop_map(case).boxed(), &|case: Case| {
        let values: Box<dyn Any> = case.values;
        test(*values.downcast().expect("what the strategy made"))
    });
}

fn run(
    config: ProptestConfig,
    strategy: &BoxedStrategy<Case>,
    test: &dyn Fn(Case) -> TestCaseResult,
) {
    let mut runner = TestRunner::new(config);
    if let Err(error) = runner.run(strategy, test) {
        panic!("{error}\n{runner}");
    }
}
