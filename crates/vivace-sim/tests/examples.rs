//! Every example runs, within two seconds.

#![expect(unreachable_pub, reason = "an example's main is called from here")]

use std::time::Instant;

/// Declares a test for each example, and one that none is missing.
macro_rules! examples {
    ($($name:ident: $path:literal),* $(,)?) => {
        $(
            #[path = $path]
            mod $name;
        )*

        mod runs {
            $(
                #[test]
                fn $name() {
                    let start = super::Instant::now();
                    super::$name::main().unwrap();
                    let seconds = start.elapsed().as_secs_f64();
                    // Ten times as long as promised: machines that run tests are slow and shared.
                    assert!(seconds < 20.0, "{seconds} s");
                }
            )*
        }

        #[test]
        fn none_is_missing() {
            let listed = [$(stringify!($name)),*];
            for entry in std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/examples")).unwrap() {
                let path = entry.unwrap().path();
                assert!(listed.contains(&path.file_stem().unwrap().to_str().unwrap()), "{}", path.display());
                assert!(std::fs::read_to_string(&path).unwrap().lines().count() <= 40, "{}", path.display());
            }
        }
    };
}

examples! {
    hang_a_cloth: "../examples/hang_a_cloth.rs",
    time_budget: "../examples/time_budget.rs",
    drag_a_corner: "../examples/drag_a_corner.rs",
    direct_solver: "../examples/direct_solver.rs",
    small_steps: "../examples/small_steps.rs",
    jelly_beam: "../examples/jelly_beam.rs",
    load_a_scene: "../examples/load_a_scene.rs",
    snapshot_and_resume: "../examples/snapshot_and_resume.rs",
    your_own_device: "../examples/your_own_device.rs",
    cloth_on_a_ball: "../examples/cloth_on_a_ball.rs",
}
