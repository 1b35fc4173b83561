//! equipoise: the server that says whether a bouncing object can be balanced.
