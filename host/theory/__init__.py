"""The paper's analytic model of one wheel (eq. dot_x_phi).

What mathematics and numbers say about it.
"""
