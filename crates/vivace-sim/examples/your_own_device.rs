//! A cloth on a device of your own, beside whatever else you do with it: nobody waits for a frame.

#[cfg(feature = "gpu")]
use vivace_sim::{Backend, Budget, Simulation, Solver, gpu::wgpu, scene::tablecloth};

/// Simulates a second; the positions of each frame arrive some frames later.
#[cfg(feature = "gpu")]
pub fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (device, queue) = pollster::block_on(async {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
        let adapter = instance.request_adapter(&wgpu::RequestAdapterOptions::default()).await?;
        Ok::<_, Box<dyn std::error::Error>>(adapter.request_device(&wgpu::DeviceDescriptor::default()).await?)
    })?;
    let backend = Backend::gpu_from_device(device, queue)?;
    let mut simulation = Simulation::new_on(&tablecloth(30), Solver::default(), backend)?;
    let (mut on_their_way, mut lowest) = (Vec::new(), 0.0_f32);
    while simulation.time() < 1.0 {
        simulation.advance(Budget::iterations(16))?;
        on_their_way.push(simulation.read_positions()?);
        // A renderer binds this buffer: `Float32x3`, stride 16. What it submits to the same queue comes after the frame.
        let resident = simulation.resident().ok_or("on a GPU")?;
        let _vertices: &wgpu::Buffer = resident.positions.raw()?;
        resident.backend.submit();
        if let Some(positions) = on_their_way[0].try_read()? {
            lowest = positions.iter().map(|p| p.y).fold(lowest, f32::min);
            drop(on_their_way.remove(0));
        }
    }
    println!("{} of {} frames were still on their way at the end", on_their_way.len(), simulation.frame());
    simulation.sync()?;
    assert!(simulation.positions().iter().all(|p| p.is_finite()) && lowest <= 0.0);
    Ok(())
}

/// Needs the feature `gpu`.
#[cfg(not(feature = "gpu"))]
pub fn main() -> Result<(), Box<dyn std::error::Error>> {
    Ok(())
}
