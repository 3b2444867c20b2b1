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
        println!("{:?}", blocked_first_fit(&g).class_sizes());
        let sf = first_fit(&g, Order::Natural);
        let bl = blocked_first_fit(&g);
        let tm = |f: &dyn Fn() -> Coloring| {
            let mut b = f64::MAX;
            let mut o = None;
            for _ in 0..reps.min(20) {
                let s = Instant::now();
                let c = f();
                b = b.min(s.elapsed().as_secs_f64() * 1e3);
                o = Some(c);
            }
            (b, o.unwrap())
        };

        let (t0, _) = tm(&|| sf.clone());
        let (t, c) = tm(&|| balance(&g, sf.clone()).coloring);
        Certificate::check(&g, c.colors()).unwrap();
        println!(
            "| balance(sff) {:.3} ratio {:.2} {} {:?}",
            t - t0,
            (t - t0) / sff,
            c.n_colors(),
            (
                c.balance(),
                c.class_sizes().iter().min().map(|&m| m as f64 * c.n_colors() as f64 / g.n_vertices() as f64)
            )
        );
        let (t, c) = tm(&|| reduce(&g, bl.clone()));
        Certificate::check(&g, c.colors()).unwrap();
        println!("| reduce(blocked) {:.3} ratio {:.2} {}", t - t0, (t - t0) / sff, c.n_colors());
        let (t2, d) = tm(&|| balance(&g, c.clone()).coloring);
        Certificate::check(&g, d.colors()).unwrap();
        println!(
            "| balance(reduced) {:.3} ratio {:.2} {} {:?}",
            t2 - t0,
            (t2 - t0) / sff,
            d.n_colors(),
            (
                d.balance(),
                d.class_sizes().iter().min().map(|&m| m as f64 * d.n_colors() as f64 / g.n_vertices() as f64)
            )
        );
    }
}
