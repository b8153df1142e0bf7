"""Analysis of the model: fixpoints, bifurcations, cycles, growth rates and attractors."""
