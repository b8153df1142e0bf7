"""The paper's simulated bodies: two-wheeled cars with one rod per wheel, and trains of them, in MuJoCo."""
