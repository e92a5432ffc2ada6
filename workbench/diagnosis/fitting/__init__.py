"""Parameters of effects by Gauss-Newton on simulations, and how certain they are."""
