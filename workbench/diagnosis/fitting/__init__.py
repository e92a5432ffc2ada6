"""Parameters of effects by Gauss-Newton on simulations, with their uncertainty."""
