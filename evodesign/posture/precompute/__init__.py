"""What is worked out once per problem."""
