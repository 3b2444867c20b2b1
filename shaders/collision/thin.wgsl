// Contacts that say nothing new. See thin.rs.

@group(1) @binding(0) var<storage, read> contacts: array<Contact>;
@group(1) @binding(1) var<storage, read> q_to: array<vec4<f32>>;
@group(1) @binding(2) var<storage, read> counts: array<u32>;
@group(1) @binding(3) var<storage, read_write> held: array<vec4<f32>>;
@group(1) @binding(4) var<storage, read_write> is_kept: array<u32>;

fn apart(k: u32) -> f32 {
    let p = contacts[k].particles;
    let aq = weighed(contacts[k].weights, q_to[p.x].xyz, q_to[p.y].xyz, q_to[p.z].xyz, q_to[p.w].xyz);
    return dot(contacts[k].normal, aq);
}

fn is_of(k: u32, point: u32) -> bool {
    return contacts[k].particles.x == point && (contacts[k].free & BETWEEN_EDGES) == 0u;
}

fn is_on(i: u32, k: u32) -> bool {
    let other = contacts[k].particles.yzw;
    for (var slot = 1u; slot < 4u; slot++) {
        if contacts[i].weights[slot] != 0.0 && !any(other == vec3(contacts[i].particles[slot])) {
            return false;
        }
    }
    return true;
}

fn scatter(i: u32) {
    var kept = 1u;
    let point = contacts[i].particles.x;
    if (contacts[i].free & BETWEEN_EDGES) == 0u {
        let here = apart(i);
        let n = min(counts[0], arrayLength(&contacts));
        var is_nearest = true;
        for (var k = i; k > 0u && is_of(k - 1u, point); k--) {
            if apart(k - 1u) <= here {
                is_nearest = false;
                if is_on(i, k - 1u) {
                    kept = 0u;
                }
            }
        }
        for (var k = i + 1u; k < n && is_of(k, point); k++) {
            if apart(k) < here {
                is_nearest = false;
                if is_on(i, k) {
                    kept = 0u;
                }
            }
        }
        if is_nearest {
            held[point] = vec4(contacts[i].normal, 0.0);
        }
    }
    is_kept[i] = kept;
}
