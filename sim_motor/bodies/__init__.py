"""The paper's simulated bodies in MuJoCo.

They are two-wheeled cars with one rod per wheel, and trains of these cars.
"""
