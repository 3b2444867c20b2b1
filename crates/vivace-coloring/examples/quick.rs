//! Scratch timing.
use std::time::Instant;
use vivace_coloring::*;
fn load(p: &str) -> ConstraintGraph {
    let b = std::fs::read(p).unwrap();
    let u = |i: usize| u32::from_le_bytes(b[i..i + 4].try_into().unwrap());
    let n = u(8) as usize;
    let nnz = u(12) as usize;
    let off = (0..=n).map(|k| u(16 + 4 * k)).collect();
    let base = 16 + 4 * (n + 1);
    let nb = (0..nnz).map(|k| u(base + 4 * k)).collect();
    ConstraintGraph::from_csr(off, nb).unwrap()
}
fn main() {
    let names: Vec<String> = std::env::args().skip(1).collect();
    let pool = |t| rayon::ThreadPoolBuilder::new().num_threads(t).build().unwrap();
    let (p1, p2) = (pool(1), pool(2));
    for name in names {
        let g = load(&format!("/tmp/graphs/{name}.csr"));
        let reps = if g.n_vertices() > 500000 {
            7
        } else if g.n_vertices() > 50000 {
            25
        } else {
            200
        };
        print!("{name:14}");
        let mut sff = 0.0;
        for a in Algorithm::ALL {
            if matches!(a, Algorithm::Dsatur) || matches!(a, Algorithm::FirstFit(o) if o!=Order::Natural) {
                continue;
            }
            let mut out = None;
            let mut t = [f64::MAX; 2];
            for _ in 0..reps {
                for (k, p) in [&p1, &p2].into_iter().enumerate() {
                    let (o, dt) = p.install(|| {
                        let s = Instant::now();
                        let o = a.color(&g);
                        (o, s.elapsed().as_secs_f64() * 1e3)
                    });
                    t[k] = t[k].min(dt);
                    if let Some(x) = &out {
                        assert_eq!(x, &o)
                    }
                    out = Some(o);
                }
            }
            if a == Algorithm::FirstFit(Order::Natural) {
                sff = t[0]
            }
            let o = out.unwrap();
            Certificate::check(&g, o.coloring.colors()).unwrap();
            print!(
                " | {} {:.3} {:.3} {} r{} v{:.2}",
                a.name(),
                t[0],
                t[1],
                o.coloring.n_colors(),
                o.rounds,
                o.visits as f64 / g.n_vertices() as f64
            );
        }
        println!(" | SFF {sff:.3}");
    }
}
