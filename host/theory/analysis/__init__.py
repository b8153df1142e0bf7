"""The mathematics: fixpoints, bifurcations, cycles, continuation, growth rates, attractors."""
