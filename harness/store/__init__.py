"""The results database: writing it (`database`) and turning it into tables (`tables`)."""
