//! A scene and how to plan in it, of the options of `portfolio` and `roadmap`.

use clap::Args;
use mp_plan::{Error, Interrupt, Request, Scene, positive_number};
use mp_ranks::Link;
use mp_stop::Cancel;
use std::path::PathBuf;

/// A scene, and the part of the options of `mp plan` that says how to plan in it.
#[derive(Clone, Debug, Args)]
pub(crate) struct Problem {
    /// A scene file, or the name of a shipped scene. Only the first rank reads it.
    scene: PathBuf,
    /// The name of the planner.
    #[arg(long, value_name = "NAME")]
    planner: Option<String>,
    /// The seed of all random numbers [default: 1].
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// The budget of iterations of a run.
    #[arg(long, value_name = "N")]
    iterations: Option<u64>,
    /// The budget of time, seconds. Where it ends the work, the result depends on the machine [default: none].
    #[arg(long, value_name = "S", value_parser = positive_number)]
    time: Option<f64>,
    /// Set a parameter of the planner.
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// A request in JSON, which docs/formats/report.md describes; other options come after it.
    #[arg(long, value_name = "FILE")]
    request: Option<PathBuf>,
    /// How many threads each rank works with. Results do not depend on it.
    #[arg(long, value_name = "N", default_value = "1", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: u16,
}

impl Problem {
    /// How many threads each rank works with.
    pub(crate) fn threads(&self) -> usize {
        self.threads.into()
    }

    /// The scene and the request, on all ranks. What is wrong with them is an error of the first rank; the others have `None` then. `planner`
    /// is for those who name none, and `check` says what else the first rank finds wrong.
    pub(crate) fn on_ranks(
        &self,
        link: &dyn Link,
        cancel: &Cancel,
        planner: impl FnOnce(&Scene) -> String,
        check: impl FnOnce(&Scene, &Request) -> Result<(), Error>,
    ) -> Result<Option<(Scene, Request)>, Error> {
        mp_batch::scene_on_ranks(link, || {
            let scene = Scene::find_until(&self.scene, &Interrupt::new(cancel.clone()))?;
            scene.notes().iter().for_each(|line| crate::output::note(&format!("note: {line}")));
            let request = self.request(planner(&scene))?;
            check(&scene, &request)?;
            Ok((scene, request))
        })
    }

    fn request(&self, planner: String) -> Result<Request, Error> {
        let mut request = match &self.request {
            Some(file) => Request::parse(file, &mp_io::read_text(file)?.1)?,
            None => {
                let mut request = Request::new(planner);
                request.budget.time_s = None;
                request
            }
        };
        if let Some(planner) = &self.planner {
            request.planner.clone_from(planner);
        }
        if let Some(seed) = self.seed {
            request.seed = seed;
        }
        if self.iterations.is_some() {
            request.budget.iterations = self.iterations;
        }
        if self.time.is_some() {
            request.budget.time_s = self.time;
        }
        let request = request.set_each(&self.set)?;
        request.check()?;
        Ok(request)
    }
}
