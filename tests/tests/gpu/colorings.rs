//! Every coloring that runs in rounds: the same bits on the GPU as on the CPU.

use vivace_coloring::Algorithm;
use vivace_cpu::Cpu;
use vivace_gpu::Gpu;
use vivace_tests::generators::{clique, empty, isolated, random, regular_hinge_cloth, star, tets};
use vivace_tests::naive::in_rounds;

#[test]
fn first() {
    let gpu = Gpu::new().unwrap();
    println!("{:?}", gpu.adapter());
    for graph in [
        tets(500, 3),
        regular_hinge_cloth(20, 20),
        star(50),
        clique(300),
        empty(),
        isolated(7),
        random(3000, 9000, 1),
    ] {
        for algorithm in Algorithm::ALL {
            let start = std::time::Instant::now();
            let a = in_rounds(&gpu, algorithm, &graph);
            let t = start.elapsed();
            let b = in_rounds(&Cpu::new(), algorithm, &graph);
            if a != b {
                let (a, b) = (a.as_ref().unwrap(), b.as_ref().unwrap());
                println!("XX {:?} {:?}", a.stragglers, b.stragglers);
                println!(
                    "XX {:?}",
                    a.colors
                        .iter()
                        .zip(&b.colors)
                        .enumerate()
                        .filter(|(_, (a, b))| a != b)
                        .collect::<Vec<_>>()
                );
            }
            assert!(
                a == b,
                "{algorithm} {} {:?} {:?}",
                graph.n_vertices(),
                a.unwrap().count,
                b.unwrap().count
            );
            println!(
                "{algorithm} {} {t:?} {:?} looks {} dispatches {}",
                graph.n_vertices(),
                b.map(|b| b.count),
                gpu.n_looks(),
                gpu.n_dispatches()
            );
        }
    }
}
