// Compiled for its precompiled headers alone, which test programs share.
