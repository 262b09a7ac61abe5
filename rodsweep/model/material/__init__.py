"""What a rod is made of along its length: constitutive laws, and profiles of stiffness and drag."""
