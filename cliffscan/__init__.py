"""The command `cliffscan`: start everything, see how it fares, look at what is published."""
