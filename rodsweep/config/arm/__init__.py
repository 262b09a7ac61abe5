"""The section `parameters.arm` of a config: an arm's quantities, and the axes of a sweep over them."""
