"""Material of a rod along its length: constitutive laws, and profiles of stiffness and drag."""
