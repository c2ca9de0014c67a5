//! Many runs: streams and lists of problems, races, and work for the ranks of a cluster.
//!
//! Scenes, requests and reports are those of [`mp_plan`]; ranks are those of [`mp_ranks`]. Results are the
//! same for any number of threads and ranks.
//!
//! ```
//! use mp_batch::plan_many;
//! use mp_plan::{Cancel, Request, Scene};
//! use std::ops::ControlFlow;
//!
//! let scene = Scene::find("easy")?;
//! let problems = (1..=8).map(|seed| (scene.clone(), Request::new("rrt-connect").seed(seed)));
//! let mut solved = 0;
//! plan_many(problems, 2, &Cancel::new(), |_, report| {
//!     solved += usize::from(report.is_ok_and(|report| report.solved));
//!     ControlFlow::Continue(())
//! });
//! assert_eq!(solved, 8);
//! # Ok::<(), mp_plan::Error>(())
//! ```
//!
//! | to | use |
//! |---|---|
//! | plan thousands of problems on all cores | [`plan_many`]; other jobs: [`in_order`] |
//! | plan the problems of a list, in shards, and go on where that ended | [`ProblemList`], [`ListedProblems::run`], [`merge_results`]; read the results: [`ListResults`] |
//! | do so on all ranks of a cluster | [`ListedProblems::run_on`] |
//! | race many runs of a hard problem, over threads and ranks | [`Portfolio`] |
//! | build a roadmap by regions, on the ranks of a cluster | `build_regions` (feature `roadmaps`) |
//! | give a scene and a request to all ranks | [`scene_on_ranks`] |

pub mod fuzz;
mod in_order;
mod job;
mod list;
mod many;
mod pieces;
mod portfolio;
mod ranks;
#[cfg(feature = "roadmaps")]
mod regions;

pub use in_order::in_order;
pub use list::{
    ItemError, ItemResult, ListResults, ListedProblems, ManyOptions, ManyOutcome, ProblemList,
    RESULTS_VERSION, RanksOutcome, ResultsHeader, SceneFingerprint, Shard, Tally, merge_results,
    scene_on_ranks,
};
pub use many::plan_many;
pub use portfolio::{Portfolio, PortfolioOptions, PortfolioOutcome, RankWork};
pub use ranks::ranks_error;
#[cfg(feature = "roadmaps")]
pub use regions::{build_regions, regions_checkpoint};
