//! The request that the options of `plan` make.

use crate::cli::Plan;
use crate::input::{is_standard, standard_input};
use mp_plan::{Budget, Error, Finish, Request, Scene};

/// The request for a scene: with the planner that suits it, unless `names_planner`.
pub(crate) fn request_for(
    scene: &Scene,
    args: &Plan,
    request: &Request,
    names_planner: bool,
) -> Result<Request, Error> {
    let mut request = request.clone();
    if !names_planner {
        let planner = if args.routes.is_some() {
            "cyclic-rrt"
        } else if args.portfolio.is_some() {
            mp_batch::Portfolio::default_planner(scene)
        } else {
            scene.default_planner()
        };
        request.planner = planner.to_owned();
        request.check()?;
    }
    Ok(request)
}

/// The request that the command line makes, and whether it names a planner. If it does not, each scene has its own, with which it is
/// checked then.
pub(crate) fn request(args: &Plan) -> Result<(Request, bool), Error> {
    let single = args.scenes.len() <= 1 && args.runs == 1;
    let threads = if single { usize::from(args.threads) } else { 1 };
    let (request, names_planner) = match &args.request {
        Some(file) => {
            let text = match is_standard(file) {
                true => standard_input()?.into_bytes(),
                false => mp_io::read_text(file)?.1,
            };
            let request = Request { threads, ..Request::parse(file, &text)? };
            let members = serde_json::from_slice::<serde_json::Value>(&text).unwrap_or_default();
            (request, members.get("planner").is_some())
        }
        None => (of_options(args, threads)?, args.planner.is_some()),
    };
    if request.roadmap.is_some() && !single {
        return Err(Error::new("--roadmap needs a single run").help("name one scene, without --runs"));
    }
    if names_planner {
        request.check()?;
    }
    Ok((request, names_planner))
}

fn of_options(args: &Plan, threads: usize) -> Result<Request, Error> {
    let mut request = Request {
        planner: args.planner.clone().unwrap_or(Request::default().planner),
        metric: args.metric,
        motion: args.motion,
        clearance: args.clearance.unwrap_or(0.0),
        objective: args.objective,
        budget: Budget { time_s: Some(args.time), iterations: args.iterations, ..Budget::default() },
        seed: args.seed,
        threads,
        finish: match (&args.relax, args.no_shorten) {
            (Some(_), _) => Finish::Relax,
            (None, true) => Finish::AsFound,
            (None, false) => Finish::Shorten,
        },
        hybridize: args.hybridize.into(),
        field: args.relax.clone().unwrap_or_default(),
        roadmap: args.roadmap.clone(),
        // A person reads it, or a certificate says it.
        sharp_clearance: args.report.is_some() || args.certificate.is_some() || !args.json,
        ..Request::default()
    };
    if let Some(step) = args.step {
        request = request.set("step", step);
    }
    request.set_each(&args.set)
}
