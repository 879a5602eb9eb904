"""The report: rows in, one HTML file with charts, stability matrix, pictures and advice out."""
