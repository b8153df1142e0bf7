"""The paper's analytic model of one wheel (eq. dot_x_phi), by mathematics and in numbers."""
