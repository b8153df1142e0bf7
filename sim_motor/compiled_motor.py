"""The functions of sim_motor.motor, compiled into those that call them.

Who imports this loads numba, which takes a second.
"""

from sim_motor import motor
from sim_motor.arrays import Array
from sim_motor.compiled import inlined_jit
from sim_motor.mathematics import with_mathematics

substep_at = with_mathematics(motor.substep_at, {}, inlined_jit)
substep_from = with_mathematics(motor.substep_from, {}, inlined_jit)
encoder = with_mathematics(motor.encoder, {}, inlined_jit)
advance = with_mathematics(motor.advance, {}, inlined_jit)


@inlined_jit
def advance_in_place(
    state: Array, substeps: int, duty: int, battery_v: float, load: float, tables: Array, c: Array
) -> None:
    """`advance` for a state kept in an array."""
    state[0], state[1], state[2], state[3], state[4], state[5] = advance(
        substeps,
        duty,
        battery_v,
        load,
        state[0],
        state[1],
        state[2],
        state[3],
        state[4],
        state[5],
        tables,
        c,
    )
