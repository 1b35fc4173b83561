//! Prices: the cost of work, known before it is done and checked against a limit.

use std::fmt;

use crate::limits;
use crate::limits::Limit;

/// The cost of one piece of work.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Price {
    bounces: u64,
    /// Most memory besides that of any work, bytes.
    bytes: u64,
}

impl Limit {
    /// Checks an amount.
    ///
    /// # Errors
    /// The amount is over the limit.
    pub fn admit(&self, amount: u64) -> Result<(), OverBudget> {
        if amount <= self.most { Ok(()) } else { Err(OverBudget { amount, limit: *self }) }
    }
}

impl Price {
    /// Price of so many bounces of the plain rod, the unit of all prices. Other bounces cost a multiple of it.
    pub fn bounces(bounces: u64) -> Self {
        Self { bounces, bytes: 0 }
    }

    /// The same price, of work that takes so many bytes of memory besides those of any work.
    pub fn taking(self, bytes: u64) -> Self {
        Self { bytes, ..self }
    }

    /// Price of the same work `factor` times. It saturates, so that an overflow passes every limit.
    pub fn times(self, factor: u64) -> Self {
        Self { bounces: self.bounces.saturating_mul(factor), bytes: self.bytes.saturating_mul(factor) }
    }

    /// Sum of two prices. It saturates too.
    pub fn and(self, other: Self) -> Self {
        Self { bounces: self.bounces.saturating_add(other.bounces), bytes: self.bytes.saturating_add(other.bytes) }
    }

    /// The price in bounces of the plain rod.
    pub fn as_bounces(self) -> u64 {
        self.bounces
    }

    /// Most memory of the work, bytes.
    pub fn as_bytes(self) -> u64 {
        self.bytes.saturating_add(limits::WORK_BYTES as u64)
    }

    /// Returns the price if it is within the limit.
    ///
    /// # Errors
    /// The price is over the limit.
    pub fn within(self, limit: &Limit) -> Result<Self, OverBudget> {
        limit.admit(self.bounces).map(|()| self)
    }
}

/// An amount over its limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OverBudget {
    /// The amount.
    pub amount: u64,
    /// The limit.
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
