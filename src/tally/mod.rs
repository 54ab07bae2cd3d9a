//! Order-free exact sums of hits.
