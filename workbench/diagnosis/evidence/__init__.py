"""Evidence: what recordings say about the residual, and which experiment would say more."""
