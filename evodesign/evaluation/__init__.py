"""One design evaluated: made ready, sized, solved, judged, with its gradients."""
