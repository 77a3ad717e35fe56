//! IF synthesis: emitters, noise, front end and quantiser.
