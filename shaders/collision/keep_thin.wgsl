// Which contacts are kept. See thin.rs.

const SAME_DIRECTION = 0.9;

@group(1) @binding(0) var<storage, read> contacts: array<Contact>;
@group(1) @binding(1) var<storage, read> held: array<vec4<f32>>;
@group(1) @binding(2) var<storage, read_write> is_kept: array<u32>;

fn is_against(one: u32, other: u32) -> bool {
    return dot(held[one].xyz, held[other].xyz) < -SAME_DIRECTION;
}

fn select_element(i: u32) -> bool {
    if is_kept[i] == 0u || (contacts[i].free & BETWEEN_EDGES) == 0u {
        return is_kept[i] != 0u;
    }
    let p = contacts[i].particles;
    return !(is_against(p.x, p.z) && is_against(p.x, p.w) && is_against(p.y, p.z) && is_against(p.y, p.w));
}
