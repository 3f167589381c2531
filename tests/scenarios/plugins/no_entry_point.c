int nothing_of_interest; /* a library without an entry point */
