//! Examples of the commands, for their help. A test reads them as the program does; `docs/cli.md` has them too.

pub(crate) const PLAN: &str = r#"Examples:
  mp plan cubicles --seed 7                      a shipped scene by name, or a file of yours
  mp plan my.toml --planner rrt-connect --out path.csv
  mp plan robot.urdf --from home --to "0.2, 0.9, 0.7, 0, 0, 0" --obstacle "box = [0.4, 0.4, 0.02], at = [0.5, 0, 0.3]"
  mp plan panda                                  a robot of ROS or Python by name: `mp robots` lists them
  mp plan cubicles --clearance 0.5               half a metre from obstacles all along
  mp plan apartment maze --runs 10 --threads 2   several scenes and seeds: a table
  mp plan easy --json --out easy.csv             one JSON object on standard output
  mp plan - --out - < my.env                     a scene comes in, a path goes out
  mp plan easy --certificate easy.json           a proof that the path is free
  mp plan apartment --routes 2 --apart 5%        routes that are far apart
  mp plan twisty --portfolio 64 --threads 2      many runs race, the one with the fewest iterations wins
  mp plan cubicles --planner prm --roadmap map   a roadmap is kept in a file, and grows with each query
  mp plan gempa-1 --planner rrs --relax          snakes bend edges and path around obstacles
  mp plan rrs-follow --relax risk --picture risk.svg
  mp plan carry                                  pick, carry, put down: a path for each part"#;

pub(crate) const MANY: &str = "Examples:
  mp many problems.jsonl --out results.jsonl
  mp many problems.jsonl --out part-2.jsonl --shard 2/3";

pub(crate) const MERGE: &str = "Examples:
  mp merge results.jsonl part-1.jsonl part-2.jsonl part-3.jsonl";

pub(crate) const CHECK: &str = r#"Examples:
  mp check easy easy.csv                    proves the path free, or says what it hits and where
  mp check easy easy.csv --clearance 0.1    also that it keeps 10 cm from obstacles
  mp check easy --at "0 0 1 0 0 0"          what is wrong there, and which configuration near is free
  mp check carry path-1.txt path-2.txt path-3.txt"#;

pub(crate) const TIME: &str = "Examples:
  mp time arm path.csv --out motion.csv
  mp time arm path.csv --out motion.yaml --rate 100   for JointTrajectory of ROS, a point every 10 ms
  mp check arm motion.csv                             proves the curve that a controller runs";

pub(crate) const INFO: &str = "Examples:
  mp info easy
  mp info robot.urdf --json";

pub(crate) const SRDF: &str = "Examples:
  mp srdf robot.urdf --out robot.srdf";

pub(crate) const IK: &str = r#"Examples:
  mp ik arm --link hand --position "0.8 0.1 0.55""#;

pub(crate) const RENDER: &str = "Examples:
  mp render easy easy.csv --out easy.png --mode wire --camera top
  mp render easy easy.csv --out easy.gif --turntable      a film; .mp4 with an installed ffmpeg, .glb for Blender
  mp render easy easy.csv --out easy.html                 a page: turn the scene, play the path
  mp render easy easy.csv --out easy.html --with-planner  a page that plans, too";

pub(crate) const VIEW: &str = "Examples:
  mp view                      the shipped scenes, to choose one
  mp view my.toml path.csv";

pub(crate) const BENCH: &str = "Examples:
  mp bench                  the suites, and how long each takes
  mp bench collide --quick";

pub(crate) const VERIFY: &str = "Examples:
  mp verify-certificate easy.json
  mp verify-certificate easy.json --scene easy
  mp verify-certificate easy.json --mesh robot=robot.off";

pub(crate) const COMPLETIONS: &str = "Examples:
  mp completions bash > ~/.local/share/bash-completion/completions/mp";

pub(crate) const MAN: &str = "Examples:
  mp man > ~/.local/share/man/man1/mp.1";
