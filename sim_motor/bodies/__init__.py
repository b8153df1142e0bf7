"""The paper's simulated bodies.

Two-wheeled cars with one rod per wheel, and trains of them, in MuJoCo.
"""
