"""Objects found late: what would be refused, looked for once more where the table and the other objects are known."""
