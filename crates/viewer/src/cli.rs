//! What a command line may hold.
