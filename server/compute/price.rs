//! What work costs, known before it is done, and the budget it has to fit in.

use std::fmt;

/// The cost of one piece of work.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Price {
    bounces: u64,
}

/// A budget, with the name and the unit that its error gives.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limit {
    /// What is limited: `work of this request`.
    pub name: &'static str,
    /// How much there may be.
    pub most: u64,
    /// Of what: `bounces`.
    pub unit: &'static str,
}

impl Limit {
    /// Refuses an `amount` beyond the limit.
    pub fn admit(&self, amount: u64) -> Result<(), OverBudget> {
        if amount <= self.most { Ok(()) } else { Err(OverBudget { amount, limit: *self }) }
    }
}

impl Price {
    /// Work of so many bounces of the plain rod, the unit of all prices. Dearer ones are multiples of it.
    pub fn bounces(bounces: u64) -> Self {
        Self { bounces }
    }

    /// The same work so many times. An absurd product is over any budget, not a small number again.
    pub fn times(self, factor: u64) -> Self {
        Self { bounces: self.bounces.saturating_mul(factor) }
    }

    /// Both pieces of work.
    pub fn and(self, other: Self) -> Self {
        Self { bounces: self.bounces.saturating_add(other.bounces) }
    }

    /// In bounces of the plain rod.
    pub fn as_bounces(self) -> u64 {
        self.bounces
    }

    /// Itself, if it is within the budget.
    pub fn within(self, limit: &Limit) -> Result<Self, OverBudget> {
        limit.admit(self.bounces).map(|()| self)
    }
}

/// Work that is refused because of its price.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OverBudget {
    /// What it would cost.
    pub amount: u64,
    /// What it may cost.
    pub limit: Limit,
}

impl fmt::Display for OverBudget {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        let Limit { name, most, unit } = self.limit;
        write!(formatter, "the {name} would be {} {unit}; the limit is {most} {unit}", self.amount)
    }
}

impl std::error::Error for OverBudget {}

#[cfg(test)]
mod tests {
    use super::*;

    const WORK: Limit = Limit { name: "work of this request", most: 100, unit: "bounces" };

    #[test]
    fn the_error_names_price_and_limit() {
        assert_eq!(Price::bounces(50).times(2).within(&WORK), Ok(Price::bounces(100)));
        let over = Price::bounces(50).times(2).and(Price::bounces(1)).within(&WORK).unwrap_err();
        assert_eq!(over.to_string(), "the work of this request would be 101 bounces; the limit is 100 bounces");
    }

    #[test]
    fn an_absurd_price_does_not_wrap() {
        assert!(Price::bounces(u64::MAX).times(2).within(&WORK).is_err());
        assert!(Price::bounces(u64::MAX).and(Price::bounces(2)).within(&WORK).is_err());
    }
}
