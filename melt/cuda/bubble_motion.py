"""CUDA twin of `melt.reference.bubble_motion`."""

import math

import numpy as np

from melt._compile import cuda, cuda_kernel
from melt.physics.bubbles import drag_loss, inside, sphere_volume, too_wide
from melt.physics.pbf import poly6, support_of
from melt.physics.phases import BUBBLE, LIQUID, SOLID


@cuda_kernel
def _bubble_predict(bubble_index, bubble_count, bubble_radius, bubbles, dt, velocity, position):
    a = cuda.grid(1)
    if a >= bubble_count[0]:
        return
    wide = position.dtype.type
    b = bubble_index[a]
    u = velocity[0, b] + dt * bubbles.rise_x
    v = velocity[1, b] + dt * bubbles.rise_y
    w = velocity[2, b] + dt * bubbles.rise_z
    velocity[0, b], velocity[1, b], velocity[2, b] = u, v, w
    r = wide(bubble_radius[b])
    x = position[0, b] + wide(dt) * wide(u)
    y = position[1, b] + wide(dt) * wide(v)
    z = position[2, b] + wide(dt) * wide(w)
    position[0, b] = inside(x, wide(bubbles.lower_x), wide(bubbles.upper_x), r)
    position[1, b] = inside(y, wide(bubbles.lower_y), wide(bubbles.upper_y), r)
    position[2, b] = inside(z, wide(bubbles.lower_z), wide(bubbles.upper_z), r)


def bubble_predict(bubble_index, bubble_count, bubble_radius, bubbles, dt, velocity, position):
    """See `melt.reference.bubble_motion.bubble_predict`."""
    _bubble_predict.launch(
        bubble_index.shape[0], bubble_index, bubble_count, bubble_radius, bubbles, dt, velocity, position,
    )


@cuda_kernel
def _bubble_exclude(phase, bubble_index, bubble_count, bubble_radius, pbf, vessel, position):
    i = cuda.grid(1)
    if i >= phase.shape[0] or phase[i] != LIQUID:
        return
    real = type(pbf.spacing)
    wide = position.dtype.type
    tiny = real(1e-18) * pbf.spacing * pbf.spacing
    x, y, z, moved = position[0, i], position[1, i], position[2, i], False
    for k in range(bubble_count[0]):
        b = bubble_index[k]
        radius = bubble_radius[b]
        if radius <= pbf.spacing:
            continue
        u, v, w = real(x - position[0, b]), real(y - position[1, b]), real(z - position[2, b])
        r2 = u * u + v * v + w * w
        if r2 < radius * radius:
            centred = r2 <= tiny
            s = real(0) if centred else radius / math.sqrt(r2)
            x = position[0, b] + wide(s * u)
            y = position[1, b] + wide(s * v)
            z = position[2, b] + wide(radius if centred else s * w)
            moved = True
    if moved:
        position[0, i] = min(max(x, wide(vessel.lower_x)), wide(vessel.upper_x))
        position[1, i] = min(max(y, wide(vessel.lower_y)), wide(vessel.upper_y))
        position[2, i] = min(max(z, wide(vessel.lower_z)), wide(vessel.upper_z))


def bubble_exclude(phase, bubble_index, bubble_count, bubble_radius, pbf, vessel, position):
    """See `melt.reference.bubble_motion.bubble_exclude`."""
    _bubble_exclude.launch(phase.shape[0], phase, bubble_index, bubble_count, bubble_radius, pbf, vessel, position)


@cuda_kernel
def _bubble_drag(
    position, phase, bubble_index, bubble_count, bubble_radius, support_radius, neighbour_count, neighbour_index,
    pbf, bubbles, dt, velocity, bubble_push,
):
    a = cuda.grid(1)
    if a >= bubble_count[0]:
        return
    real = type(pbf.support)
    wide = position.dtype.type
    b = bubble_index[a]
    x_b, y_b, z_b = position[0, b], position[1, b], position[2, b]
    u_b, v_b, w_b = velocity[0, b], velocity[1, b], velocity[2, b]
    SW = u = v = w = wide(0)
    for k in range(neighbour_count[b]):
        j = neighbour_index[b, k]
        x = real(x_b - position[0, j])
        y = real(y_b - position[1, j])
        z = real(z_b - position[2, j])
        # bubbles have no radius of their own: R_bj is that of the liquid, and of no use for others
        R = support_of(b, j, support_radius, pbf) if phase[j] == LIQUID else pbf.support
        inverse = real(1) / R
        W1 = poly6(x * x + y * y + z * z, inverse, real(315 / (64 * math.pi)) * inverse * inverse * inverse)
        W1 = W1 if phase[j] == LIQUID else real(0)
        SW += W1
        u += W1 * (u_b - velocity[0, j]) if phase[j] == LIQUID else real(0)
        v += W1 * (v_b - velocity[1, j]) if phase[j] == LIQUID else real(0)
        w += W1 * (w_b - velocity[2, j]) if phase[j] == LIQUID else real(0)
    per_weight = real(1) / real(SW) if SW > wide(0) else real(0)
    du, dv, dw = per_weight * real(u), per_weight * real(v), per_weight * real(w)  # v_b - u_b
    r = bubble_radius[b]
    if too_wide(r, pbf.support):  # as in liquid at rest
        du, dv, dw, per_weight = u_b, v_b, w_b, real(0)
    s0 = math.sqrt(du * du + dv * dv + dw * dw)
    loss = drag_loss(r, real(4) * bubbles.drag * dt * s0) if s0 > real(0) else real(0)
    push = bubbles.inertia * sphere_volume(r) * loss * per_weight
    velocity[0, b] = u_b - loss * du
    velocity[1, b] = v_b - loss * dv
    velocity[2, b] = w_b - loss * dw
    bubble_push[0, b] = push * du
    bubble_push[1, b] = push * dv
    bubble_push[2, b] = push * dw


def bubble_drag(
    position, phase, bubble_index, bubble_count, bubble_radius, support_radius, neighbour_count, neighbour_index,
    pbf, bubbles, dt, velocity, bubble_push,
):
    """See `melt.reference.bubble_motion.bubble_drag`."""
    _bubble_drag.launch(
        bubble_index.shape[0], position, phase, bubble_index, bubble_count, bubble_radius, support_radius,
        neighbour_count, neighbour_index, pbf, bubbles, dt, velocity, bubble_push,
    )


@cuda_kernel
def _bubble_reaction(
    position, phase, mass, support_radius, bubble_push, neighbour_count, neighbour_index, pbf, velocity,
):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    real = type(pbf.support)
    wide = position.dtype.type
    if phase[i] != LIQUID:
        return
    u = v = w = wide(0)
    for k in range(neighbour_count[i]):
        b = neighbour_index[i, k]
        if phase[b] != BUBBLE:
            continue
        x = real(position[0, i] - position[0, b])
        y = real(position[1, i] - position[1, b])
        z = real(position[2, i] - position[2, b])
        inverse = real(1) / support_of(i, b, support_radius, pbf)
        W1 = poly6(x * x + y * y + z * z, inverse, real(315 / (64 * math.pi)) * inverse * inverse * inverse)
        u += W1 * bubble_push[0, b]
        v += W1 * bubble_push[1, b]
        w += W1 * bubble_push[2, b]
    per_mass = real(1) / mass[i]
    velocity[0, i] += per_mass * real(u)
    velocity[1, i] += per_mass * real(v)
    velocity[2, i] += per_mass * real(w)


def bubble_reaction(
    position, phase, mass, support_radius, bubble_push, neighbour_count, neighbour_index, pbf, velocity,
):
    """See `melt.reference.bubble_motion.bubble_reaction`."""
    _bubble_reaction.launch(
        phase.shape[0], position, phase, mass, support_radius, bubble_push, neighbour_count,
        neighbour_index, pbf, velocity,
    )


@cuda_kernel
def _bubble_move(bubble_index, bubble_count, bubble_radius, velocity, position_predicted, bubbles, dt, position):
    a = cuda.grid(1)
    if a >= bubble_count[0]:
        return
    wide = position.dtype.type
    b = bubble_index[a]
    r = wide(bubble_radius[b])
    x = position_predicted[0, b] + wide(dt) * wide(velocity[0, b])
    y = position_predicted[1, b] + wide(dt) * wide(velocity[1, b])
    z = position_predicted[2, b] + wide(dt) * wide(velocity[2, b])
    position[0, b] = inside(x, wide(bubbles.lower_x), wide(bubbles.upper_x), r)
    position[1, b] = inside(y, wide(bubbles.lower_y), wide(bubbles.upper_y), r)
    position[2, b] = inside(z, wide(bubbles.lower_z), wide(bubbles.upper_z), r)


def bubble_move(bubble_index, bubble_count, bubble_radius, velocity, position_predicted, bubbles, dt, position):
    """See `melt.reference.bubble_motion.bubble_move`."""
    _bubble_move.launch(
        bubble_index.shape[0], bubble_index, bubble_count, bubble_radius, velocity, position_predicted,
        bubbles, dt, position,
    )


@cuda_kernel
def _bubble_drift(
    position, phase, bubble_index, bubble_count, neighbour_count, neighbour_index, bubbles, dt, bubble_shift,
):
    a = cuda.grid(1)
    if a >= bubble_count[0]:
        return
    real = type(bubbles.drift)
    step = bubbles.drift * dt
    b = bubble_index[a]
    sum_x = sum_y = either_x = either_y = np.int32(0)
    for k in range(neighbour_count[b]):
        j = neighbour_index[b, k]
        if phase[j] != BUBBLE:
            continue
        more, less = position[0, j] > position[0, b], position[0, j] < position[0, b]
        sum_x += np.int32(more) - np.int32(less)
        either_x += np.int32(more or less)
        more, less = position[1, j] > position[1, b], position[1, j] < position[1, b]
        sum_y += np.int32(more) - np.int32(less)
        either_y += np.int32(more or less)
    count_x = max(either_x, np.int32(1)) if bubbles.normalised == 1 else np.int32(1)
    count_y = max(either_y, np.int32(1)) if bubbles.normalised == 1 else np.int32(1)
    bubble_shift[0, b] = step * (real(sum_x) / real(count_x))  # (13)
    bubble_shift[1, b] = step * (real(sum_y) / real(count_y))


def bubble_drift(
    position, phase, bubble_index, bubble_count, neighbour_count, neighbour_index, bubbles, dt, bubble_shift,
):
    """See `melt.reference.bubble_motion.bubble_drift`."""
    _bubble_drift.launch(
        bubble_index.shape[0], position, phase, bubble_index, bubble_count, neighbour_count,
        neighbour_index, bubbles, dt, bubble_shift,
    )


@cuda_kernel
def _bubble_shift(bubble_index, bubble_count, bubble_radius, bubble_shift, bubbles, position):
    a = cuda.grid(1)
    if a >= bubble_count[0]:
        return
    wide = position.dtype.type
    b = bubble_index[a]
    r = wide(bubble_radius[b])
    x = position[0, b] + wide(bubble_shift[0, b])
    y = position[1, b] + wide(bubble_shift[1, b])
    position[0, b] = inside(x, wide(bubbles.lower_x), wide(bubbles.upper_x), r)
    position[1, b] = inside(y, wide(bubbles.lower_y), wide(bubbles.upper_y), r)


def bubble_shift(bubble_index, bubble_count, bubble_radius, bubble_shift, bubbles, position):
    """See `melt.reference.bubble_motion.bubble_shift`."""
    _bubble_shift.launch(
        bubble_index.shape[0], bubble_index, bubble_count, bubble_radius, bubble_shift, bubbles, position,
    )


@cuda_kernel
def _bubble_avoid(phase, bubble_index, bubble_count, bubble_radius, neighbour_count, neighbour_index, bubbles, position):
    a = cuda.grid(1)
    if a >= bubble_count[0]:
        return
    real = type(bubbles.spacing)
    wide = position.dtype.type
    b = bubble_index[a]
    reach = bubble_radius[b] + real(0.5) * bubbles.spacing
    dx = dy = dz = wide(0)
    touching = real(0)
    for k in range(neighbour_count[b]):
        j = neighbour_index[b, k]
        if phase[j] != SOLID:
            continue
        x = real(position[0, b] - position[0, j])
        y = real(position[1, b] - position[1, j])
        z = real(position[2, b] - position[2, j])
        r = math.sqrt(x * x + y * y + z * z)
        if r < reach and r > real(1e-9) * bubbles.spacing:
            f = reach / r - real(1)
            dx += f * x
            dy += f * y
            dz += f * z
            touching += real(1)
    if touching > real(0):
        share = wide(real(1) / touching)
        r = wide(bubble_radius[b])
        position[0, b] = inside(position[0, b] + share * dx, wide(bubbles.lower_x), wide(bubbles.upper_x), r)
        position[1, b] = inside(position[1, b] + share * dy, wide(bubbles.lower_y), wide(bubbles.upper_y), r)
        position[2, b] = inside(position[2, b] + share * dz, wide(bubbles.lower_z), wide(bubbles.upper_z), r)


def bubble_avoid(phase, bubble_index, bubble_count, bubble_radius, neighbour_count, neighbour_index, bubbles, position):
    """See `melt.reference.bubble_motion.bubble_avoid`."""
    _bubble_avoid.launch(
        bubble_index.shape[0], phase, bubble_index, bubble_count, bubble_radius, neighbour_count, neighbour_index,
        bubbles, position,
    )
