//! Plans for a scene, a file or the name of a shipped one, and prints the path.

use mp_plan::{Error, Request, Scene};

fn main() -> Result<(), Error> {
    let name = std::env::args().nth(1).unwrap_or_else(|| "easy".to_owned());
    let scene = Scene::find(name)?;
    let report = scene.plan(&Request::new("rrt-connect").seed(7).time(30.0))?;
    let Some(path) = &report.path else {
        return Err(Error::new(report.why.unwrap_or_default()));
    };
    println!("{} configurations, clear by {:?} m", path.len(), report.clearance.unwrap_or_default());
    path.iter().for_each(|row| println!("{row:?}"));
    Ok(())
}
