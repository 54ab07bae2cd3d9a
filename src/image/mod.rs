//! EXR, PNG, false colour, drawing.
