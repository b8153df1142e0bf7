"""What the paper claims, in a sentence each; what was measured is in docs/claims.md."""

from __future__ import annotations

SENTENCES = {
    "R1": "forward and backward locomotion coexist; the start alone decides between them",
    "R2": "at k = 8 a wheel makes about 2 turns per second",
    "R3": "at k = 8 the robot drives at 0.35 m/s, with 80 to 90 % of the motor's power",
    "R4": "the torque M hardly changes in locomotion",
    "R5": "the motor stalls for |M| <= 0.1",
    "R6": "as k decreases, M jumps to zero at k_c; above k_c, rest and locomotion coexist",
    "R7": (
        "kicks alone lead from each of forward, backward and both spins to each other; a pulse "
        "of k leads to rest"
    ),
    "R8": "inverting the membrane potentials always reverses the wheels",
    "R9": "inverting the positions (beta = 1) reverses a wheel reliably if it lasts 3 to 5 ticks",
    "R10": (
        "a phase shift of 3 pi/4, positive for forward wheels and negative for backward ones, "
        "reverses a wheel reliably if it lasts 3 to 5 ticks"
    ),
    "R11": (
        "settling into the reversed cycle takes longer than the kick, at times half a second or"
        " more"
    ),
    "R12": "a kick changes the relative phase of the left and the right wheel (phase slip)",
    "R13": "at k = 2 a robot that hits a wall reverses by itself, with no sensor for it",
    "R14": "at k = 15 and tau = 1000 ms the motors switch irregularly: the motion is chaotic",
    "M1": (
        "a wheel has eight fixpoints, omega = 0 and phi = n pi/4; those with odd n are always "
        "unstable"
    ),
    "M2": "two wheels have 16 non-moving states",
    "M3": "rest becomes unstable at about k_c = 2 f / (a tau)",
    "M4": "at tau = 0.25 s a wheel rests at k = 1.4, swings at 1.65 and rolls at 1.85",
    "M5": (
        "the Hopf bifurcation is supercritical; its four cycles grow until they merge with the "
        "saddles into a rotation"
    ),
    "M6": "far above the onset, locomotion has the speed of the constant-velocity formula",
    "M7": "the plane (k, tau) has four phases, S, FB, LLM and C; rest ends near k tau = 2 f / a",
    "M8": "at k = 15 and tau = 1 s a wheel is chaotic: its largest Lyapunov exponent is positive",
    "M9": "the membrane potentials of a wheel that turns steadily are those of the paper's formula",
    "B1": (
        "a car with one rod for each wheel follows intricate trajectories, and stays inside "
        "confining slopes"
    ),
    "B2": (
        "from random phases, the ten wheels of a train find one speed and direction by themselves"
    ),
    "B3": "a train reverses as a whole at a wall, with no sensor for it",
}
