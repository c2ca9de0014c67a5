//! `roadmap`: a roadmap by regions.

use crate::output::{note, print};
use crate::request::Problem;
use clap::Args;
use mp_batch::{build_regions, ranks_error, regions_checkpoint};
use mp_plan::{Claims, Error, Request, Scene};
use mp_ranks::{Link, Options};
use mp_stop::Cancel;
use std::ffi::OsString;
use std::path::PathBuf;

/// The only planner whose roadmaps are built by regions.
const PLANNER: &str = "regional-prm";

/// The options of `mp plan --planner regional-prm` that say what is built.
#[derive(Clone, Debug, Args)]
pub(crate) struct Regions {
    #[command(flatten)]
    problem: Problem,
    /// The file for the roadmap: `mp plan SCENE --planner regional-prm --roadmap FILE` goes on with it. Results of regions are kept in
    /// FILE.regions until all are there, so that a job that was killed goes on.
    #[arg(long, value_name = "FILE")]
    roadmap: PathBuf,
}

impl Regions {
    fn checkpoint(&self) -> PathBuf {
        let mut name = OsString::from(&self.roadmap);
        name.push(".regions");
        name.into()
    }

    /// Refuses what cannot be built, outputs that are inputs, and a roadmap that is there already.
    fn check(&self, scene: &Scene, request: &Request) -> Result<(), Error> {
        scene.regions(request)?;
        if request.budget.time_s.is_some() {
            return Err(Error::new("a roadmap by regions has no budget of time")
                .help("leave it out: Ctrl-C ends the job, and the same command goes on"));
        }
        let mut claims = Claims::default();
        scene.inputs_on_disk().iter().for_each(|file| claims.input(file));
        claims.output("--roadmap", &self.roadmap)?;
        claims.output("--roadmap", &self.checkpoint())?;
        if self.roadmap.exists() {
            return Err(Error::new(format!("{} is there already", self.roadmap.display()))
                .help("name another file, or delete it to build the roadmap again"));
        }
        Ok(())
    }
}

/// Builds a roadmap. True when it is whole.
pub(crate) fn run(args: &Regions, link: &dyn Link, cancel: &Cancel) -> Result<bool, Error> {
    let mut checkpoint = None;
    let problem = args.problem.on_ranks(
        link,
        cancel,
        |_| PLANNER.to_owned(),
        |scene, request| {
            args.check(scene, request)?;
            checkpoint = Some(regions_checkpoint(scene, request, &args.checkpoint())?);
            Ok(())
        },
    )?;
    // The first rank says why.
    let Some((scene, request)) = problem else { return Ok(true) };
    let work = scene.regions(&request)?;
    if let Some(known) = checkpoint.as_ref().map(|checkpoint| checkpoint.known().len())
        && known > 0
    {
        note(&format!("going on after {known} of {} items", work.items()));
    }
    let options = Options { threads: args.problem.threads(), cancel: cancel.clone() };
    let built = build_regions(&work, link, &options, checkpoint.as_ref())?;
    if !link.is_master() {
        return Ok(true);
    }
    let Some(mut roadmap) = built else {
        note("interrupted; the same command goes on");
        return Ok(false);
    };
    roadmap.save(&args.roadmap)?;
    if let Some(checkpoint) = checkpoint {
        checkpoint.delete().map_err(ranks_error)?;
    }
    print(&format!(
        "{} regions: {} nodes, {} edges, {} components",
        work.regions(),
        roadmap.nodes(),
        roadmap.edges(),
        roadmap.components()
    ))?;
    Ok(true)
}
