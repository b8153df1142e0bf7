"""How states are followed in time: integrators, ensembles of wheels, sampled and kicked wheels."""
