//! # abbe: from a machine configuration to volumetric compensation
